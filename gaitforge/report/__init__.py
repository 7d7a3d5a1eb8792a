"""Tables, plots and the page that a person reads; `summary` builds what a program reads."""
