"""The report page: a template, a style sheet, and what draws them from a record."""
