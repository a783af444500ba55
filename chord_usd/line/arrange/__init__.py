"""What is done to furniture after it is read: one table of rules, every change kept."""
