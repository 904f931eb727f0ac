//! Independent work on all processors.

/// Applies `act` to each item and returns the results in the order of the items. WebAssembly has
/// one thread, so it runs them one after the other.
pub fn map_in_parallel<T: Send, R: Send>(
    items: impl IntoIterator<Item = T>,
    act: impl Fn(T) -> R + Sync,
) -> Vec<R> {
    #[cfg(not(target_family = "wasm"))]
    {
        use rayon::iter::{IntoParallelIterator, ParallelIterator};
        items
            .into_iter()
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(&act)
            .collect()
    }
    #[cfg(target_family = "wasm")]
    items.into_iter().map(act).collect()
}
