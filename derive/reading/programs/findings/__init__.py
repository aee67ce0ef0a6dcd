"""What programs compute: equations, methods of integration and their faults."""
