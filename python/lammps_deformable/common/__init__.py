"""Tools for all other folders: errors, checks of arguments, progress, parallel runs."""
