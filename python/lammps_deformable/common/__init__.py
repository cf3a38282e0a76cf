"""What all other folders use: errors, checks of arguments, files and locks, ranks, the box."""
