"""Plants and their parts as tables of plain values, as files hold them; a plant's type by its name."""
