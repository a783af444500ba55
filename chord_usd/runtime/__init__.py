"""What every part stands on: outputs that appear whole, foreign files, networks, child processes."""
