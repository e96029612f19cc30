"""What people read: text that is safe to print, names of metrics, the shape of a warning."""
