pub fn budget() -> Result<(), String> {
    Ok(())
}
