"""Verification in simulation: scene → simulator → recording → trace → checks → verdict.

A simulator fills a `recording.Recording` with states and contacts and nothing else;
`assemble.assemble_trace` derives the `trace.Trace`, the `checks` judge it, and
`verify.verify_timeline` does all of it.
"""
