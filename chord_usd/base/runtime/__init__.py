"""What every part stands on: outputs, foreign files, networks, processes, progress, interrupts."""
