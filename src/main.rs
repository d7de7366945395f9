//! The `quadfront` program: everything is in the library's `app`.

fn main() -> std::process::ExitCode {
    quadfront::app::run()
}
