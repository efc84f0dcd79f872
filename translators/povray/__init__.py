"""The translator to POV-Ray 3.7 and its adapter."""
