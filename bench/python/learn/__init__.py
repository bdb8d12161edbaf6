"""The benchmark of learned policies: training, evaluation and docs/notes/benchmark.md. Uses the public interface of taxelsim only."""
