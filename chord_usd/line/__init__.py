"""The line from a plan to pictures, a folder for each step."""
