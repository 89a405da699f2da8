"""What recordings will tell before anything is fitted, and which recordings would tell what is wanted."""
