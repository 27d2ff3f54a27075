//! Space that is cut off (spec section 4, decision "cut-off vertices").

/// `(Σ u_i / (|V_q|·|V|))²`, in [0, 1]: u_i vertices of `V` that query vertex i reached in the initial
/// layout and does not reach now. 0 where either region is empty.
pub fn disconnection(cut_off: u64, query: usize, vertices: usize) -> f64 {
    if query == 0 || vertices == 0 {
        return 0.0;
    }
    let share = cut_off as f64 / (query as f64 * vertices as f64);
    share * share
}
