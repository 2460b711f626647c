"""Stratified samples with exact weights."""
