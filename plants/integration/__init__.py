"""One simulation or one step: step maps with their derivatives, adaptive methods, batch stepper."""
