"""What comes from outside: odd files, odd commands and odd moments, and how to watch for harm."""
