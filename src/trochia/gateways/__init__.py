"""Other programs' protocols on top of the controller: bytes in, commands out; status in, bytes out."""
