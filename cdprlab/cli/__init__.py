"""The command line: what can be asked of a world without writing a program."""
