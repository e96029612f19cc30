"""What people see of a result: facts, pages, figures, and documents of commands."""
