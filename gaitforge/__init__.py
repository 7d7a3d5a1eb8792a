"""gaitforge: from a handful of robot modules to a walking, working robot in seconds."""

__version__ = "0.1.0"
