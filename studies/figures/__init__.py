"""Every picture, by what it shows."""
