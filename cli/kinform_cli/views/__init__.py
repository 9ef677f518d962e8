"""What `kinform show` prints for people: one module a topic, and `topics`, which knows them all."""
