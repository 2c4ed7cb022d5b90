"""A scene's parameters from files of measured motions: the result as a table, a picture and text."""
