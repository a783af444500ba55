"""Many plans -> many houses: units of work, the engines that do them, and what they leave."""
