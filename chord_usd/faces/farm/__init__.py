"""A stage as a job for render farms."""
