"""The benchmark of learned policies: training, evaluation and docs/benchmark.md. Uses the public interface of taxelsim only."""
