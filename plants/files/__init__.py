"""How files are written and read: whole or as they were before, and refused by name where they are not Pliant's own."""
