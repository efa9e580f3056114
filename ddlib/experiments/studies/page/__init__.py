"""What readers try in the pages, many times over.

- ``training``: networks trained as a reader trains one: when errors go, and shapes come
"""
