"""What a page shows without a kernel: values computed beforehand, compressed, and a still."""
