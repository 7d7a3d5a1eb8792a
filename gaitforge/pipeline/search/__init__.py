"""One gait, transition or stand: candidates in order of promise, several at once, until one has a plan."""
