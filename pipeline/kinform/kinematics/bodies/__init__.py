"""The bodies and joints of an assembly."""
