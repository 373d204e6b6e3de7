fn main() -> std::process::ExitCode {
    octray::cli::main()
}
