"""Files, the machine, number formats, progress, motions computed once."""
