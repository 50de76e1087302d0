# Builds the program and an image that runs it:
#
#     docker build -t etalon .
#     docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/work" etalon render scenes/cornell.json --spp 64 -o cornell.png
#
# `cargo xtask docker-steps` runs the steps of this file by hand, without Docker.

FROM rust:1-slim-bookworm AS build
WORKDIR /source
COPY . .
RUN cargo install --locked --path crates/cli --root /opt/etalon

FROM debian:bookworm-slim
COPY --from=build /opt/etalon/bin/etalon /usr/local/bin/etalon
WORKDIR /work
ENTRYPOINT ["etalon"]
CMD ["--help"]
