"""Plants with quaternions among their coordinates: equations, rests, linear models in small turns."""
