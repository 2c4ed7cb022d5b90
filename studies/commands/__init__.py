"""The command line; only it imports typer and rich."""
