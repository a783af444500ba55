"""The verbs of the command line: each reads, calls, writes and says what came out."""
