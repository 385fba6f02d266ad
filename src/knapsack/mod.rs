//! The multiple-choice knapsack.
