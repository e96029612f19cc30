"""What the logs cannot tell, and the drives that would."""
