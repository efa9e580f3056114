"""What readers try in the pages of Part IV."""
