"""The page in the browser: a server that runs the verbs, and what it serves."""
