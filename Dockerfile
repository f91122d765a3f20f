# docker build --tag ev-stack . && docker run --rm --volume "$PWD/results:/ev-stack/results" ev-stack shchur2019
FROM python:3.11-slim
WORKDIR /ev-stack
COPY . .
RUN scripts/setup.sh
ENTRYPOINT ["scripts/run.sh"]
CMD ["--list"]
