"""A whole motion of one state in one native call: its C, when that is worth compiling, and the library it becomes."""
