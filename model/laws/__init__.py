"""model/laws"""
