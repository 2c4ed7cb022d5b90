"""One simulation or one step: step maps, adaptive methods, batch stepper."""
